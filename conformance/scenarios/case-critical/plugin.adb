with RobotTestingFramework.Asserter; use RobotTestingFramework.Asserter;
with RobotTestingFramework.Cases;    use RobotTestingFramework.Cases;

package body Plugin is

   procedure Pass is null;

   procedure Dangerous is
   begin
      Require_Critical (False, "the arm is free");
   end Dangerous;

   overriding procedure Run (Self : in out Test) is
   begin
      Run_Case ("dangerous", Dangerous'Access);
      Run_Case ("never", Pass'Access);
   end Run;

end Plugin;
