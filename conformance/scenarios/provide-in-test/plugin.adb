with RobotTestingFramework.FixtureManager;

package body Plugin is

   overriding procedure Run (Self : in out Test) is
   begin
      RobotTestingFramework.FixtureManager.Provide ("port", 40123);
   end Run;

end Plugin;
