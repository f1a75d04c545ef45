with RobotTestingFramework.Asserter; use RobotTestingFramework.Asserter;

package body Plugin is

   overriding function Setup (Self : in out Test; Parameters : String) return Boolean is
   begin
      Skip ("no robot");
      return True;
   end Setup;

   overriding procedure Run (Self : in out Test) is
   begin
      Report ("run was called");
   end Run;

   overriding procedure TearDown (Self : in out Test) is
   begin
      Report ("torn down");
   end TearDown;

end Plugin;
