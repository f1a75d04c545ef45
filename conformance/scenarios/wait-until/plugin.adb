with RobotTestingFramework.Session;

package body Plugin is

   overriding procedure Run (Self : in out Test) is
      function Never return Boolean is (False);
      procedure Wait is new RobotTestingFramework.Session.Wait_Until (Never);
   begin
      Wait (0.2, "the door to open");
   end Run;

end Plugin;
