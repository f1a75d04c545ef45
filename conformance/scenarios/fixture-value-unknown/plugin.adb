with RobotTestingFramework.Asserter; use RobotTestingFramework.Asserter;
with RobotTestingFramework.Session;  use RobotTestingFramework.Session;

package body Plugin is

   overriding procedure Run (Self : in out Test) is
   begin
      Report (Fixture_Value ("simulator.speed"));
   end Run;

   overriding procedure TearDown (Self : in out Test) is
   begin
      Report ("torn down");
   end TearDown;

end Plugin;
