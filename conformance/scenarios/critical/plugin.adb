with RobotTestingFramework.Asserter; use RobotTestingFramework.Asserter;

package body Plugin is

   overriding procedure Run (Self : in out Test) is
   begin
      Require_Critical (False, "the emergency stop is pressed");
   end Run;

end Plugin;
