with RobotTestingFramework.Asserter; use RobotTestingFramework.Asserter;
with RobotTestingFramework.Session; use RobotTestingFramework.Session;

package body Plugin is

   overriding procedure Run (Self : in out Test) is
   begin
      Sample ("q", 0.0, "rad", Time => 0.5);
      Sample ("q", 1.0, "rad", Time => 1.5);
      Sample ("q", 1.0, "rad", Time => 2.5);
      Check_Trajectory ("q", "golden/a.csv", 0.05);
      Check_Trajectory ("q", "golden/b.csv", 0.5, By_Warping, 0.25);
      Report ("the test continues");
   end Run;

end Plugin;
