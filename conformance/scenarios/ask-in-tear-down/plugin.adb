with RobotTestingFramework.Asserter; use RobotTestingFramework.Asserter;
with RobotTestingFramework.Session;  use RobotTestingFramework.Session;

package body Plugin is

   overriding procedure Run (Self : in out Test) is
   begin
      Report ("running");
   end Run;

   overriding procedure TearDown (Self : in out Test) is
   begin
      Report (Ask ("Is the hand closed?", Default => "no"));
      Report ("not reached");
   end TearDown;

end Plugin;
