with RobotTestingFramework.Asserter; use RobotTestingFramework.Asserter;
with RobotTestingFramework.Session; use RobotTestingFramework.Session;

package body Plugin is

   overriding procedure Run (Self : in out Test) is
   begin
      Check_Picture ("scene", "scene.png", "stored.png", 0.01);
      Check_Picture ("scene", "scene.png", "scene.png", 0.0);
      Check_Picture ("scene", "scene.png", "golden/none.png", 0.01);
      Report ("the test continues");
   end Run;

end Plugin;
