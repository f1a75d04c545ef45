with RobotTestingFramework.Asserter; use RobotTestingFramework.Asserter;

package body Plugin is

   overriding function Setup (Self : in out Test; Parameters : String) return Boolean is
   begin
      return False;
   end Setup;

   overriding procedure Run (Self : in out Test) is
   begin
      Report ("never");
   end Run;

   overriding procedure TearDown (Self : in out Test) is
   begin
      Report ("torn down");
   end TearDown;

end Plugin;
