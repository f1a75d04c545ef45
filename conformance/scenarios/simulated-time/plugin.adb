with RobotTestingFramework.Asserter; use RobotTestingFramework.Asserter;
with RobotTestingFramework.Session;  use RobotTestingFramework.Session;

package body Plugin is

   overriding procedure Run (Self : in out Test) is
      Start : constant Duration := Current_Time;
      function Never return Boolean is (False);
      procedure Wait is new Wait_Until (Never);
   begin
      Sleep (20.0);
      Check (Current_Time - Start >= 20.0, "twenty seconds have passed");
      Wait (10.0, "the door to open");
   end Run;

end Plugin;
