with RobotTestingFramework.Asserter; use RobotTestingFramework.Asserter;
with RobotTestingFramework.Cases;    use RobotTestingFramework.Cases;

package body Plugin is

   procedure Pass is null;

   procedure Moves is
   begin
      Check (False, "it moves");
   end Moves;

   procedure Arm is
   begin
      Run_Case ("Moves", Moves'Access);
      Run_Case ("Stops", Pass'Access);
   end Arm;

   overriding procedure Run (Self : in out Test) is
   begin
      Run_Case ("Arm", Arm'Access);
      Run_Case ("Hand", Pass'Access);
   end Run;

end Plugin;
