with RobotTestingFramework.Asserter; use RobotTestingFramework.Asserter;

package body Plugin is

   overriding procedure Run (Self : in out Test) is
   begin
      Check_Near (1.25, 1.0, 0.1, "gain");
      Check_Near ((1.0, 2.0, 3.5), (1.0, 2.0, 3.0), 0.1, "pose");
      Check_Angle_Near (3.1, -3.1, 0.1, "heading");
      Check_Angle_Near (0.0, 1.0, 0.1, "yaw");
   end Run;

end Plugin;
