with RobotTestingFramework.Asserter; use RobotTestingFramework.Asserter;
with RobotTestingFramework.Cases;    use RobotTestingFramework.Cases;

package body Plugin is

   procedure Pass is null;

   procedure Assert is
   begin
      Require (False, "it moves");
   end Assert;

   procedure End_With_Error is
   begin
      Error ("no bench");
   end End_With_Error;

   procedure Surprise is
   begin
      raise Constraint_Error with "surprise";
   end Surprise;

   overriding procedure Run (Self : in out Test) is
   begin
      Run_Case ("assertion", Assert'Access);
      Run_Case ("error", End_With_Error'Access);
      Run_Case ("exception", Surprise'Access);
      Run_Case ("after", Pass'Access);
   end Run;

end Plugin;
