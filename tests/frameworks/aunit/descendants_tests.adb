with Ada.Environment_Variables;
with AUnit.Assertions; use AUnit.Assertions;
with AUnit.Options;
with AUnit.Reporter.Text;
with AUnit.Test_Results;
with Interfaces.C; use Interfaces.C;
with RTF_AUnit;

package body Descendants_Tests is

   use AUnit.Test_Cases;

   Descendants : aliased Descendants_Case;
   Inner       : aliased Inner_Case;

   --  In tests/frameworks/descendants/deeds.cpp.
   function Descendants_Hold (Deed : char_array) return int
   with Import, Convention => C, External_Name => "descendants_hold";

   generic
      Deed : String;
   procedure Check (Self : in out Test_Case'Class);

   procedure Check (Self : in out Test_Case'Class) is
      pragma Unreferenced (Self);
   begin
      Assert (Descendants_Hold (To_C (Deed)) = 1, "the case does not hold");
   end Check;

   procedure Executes_Itself is new Check ("executes_itself");
   procedure Executes_Itself_Twice is new Check ("executes_itself_twice");
   procedure Needs_A_Descendant_That_Fails is new Check ("needs_a_descendant_that_fails");
   procedure Expects_A_Descendant_That_Fails is new Check ("expects_a_descendant_that_fails");
   procedure Executes_Itself_Without_Environment is
     new Check ("executes_itself_without_environment");
   procedure Expects_A_Failure_Without_Environment is
     new Check ("expects_a_failure_without_environment");
   procedure Spawns_Itself is new Check ("spawns_itself");
   procedure Needs_A_Spawned_Descendant_That_Fails is
     new Check ("needs_a_spawned_descendant_that_fails");
   procedure Reads_What_A_Descendant_Prints is new Check ("reads_what_a_descendant_prints");
   procedure Has_An_Environment_Of_Its_Own is new Check ("has_an_environment_of_its_own");
   procedure Forks_And_Exits is new Check ("forks_and_exits");
   procedure Forks_And_Exits_With_A_Code is new Check ("forks_and_exits_with_a_code");
   procedure Forks_And_Exits_At_Once is new Check ("forks_and_exits_at_once");
   procedure Forks_And_Aborts is new Check ("forks_and_aborts");
   procedure Forks_And_Returns is new Check ("forks_and_returns");
   procedure Forks_And_Fails is new Check ("forks_and_fails");
   procedure Needs_A_Fork_That_Fails is new Check ("needs_a_fork_that_fails");
   procedure Passes is new Check ("passes");
   procedure Fails is new Check ("fails");

   procedure Inner_Passes (Self : in out Test_Case'Class) is null;
   procedure Runs_AUnit_In_AUnit (Self : in out Test_Case'Class);

   --  The results of the inner run are no results of this one.
   procedure Runs_AUnit_In_AUnit (Self : in out Test_Case'Class) is
      use type AUnit.Status;
      use AUnit.Test_Suites;
      pragma Unreferenced (Self);
      Inner_Suite : constant Access_Test_Suite := New_Suite;
      Reporter    : AUnit.Reporter.Text.Text_Reporter;
      Results     : AUnit.Test_Results.Result;
      Outcome     : AUnit.Status;
   begin
      if Ada.Environment_Variables.Exists ("DESCENDANT_ROLE") then
         return;
      end if;
      Inner_Suite.Add_Test (Inner'Access);
      RTF_AUnit.Run (Inner_Suite, Reporter, Results, AUnit.Options.Default_Options, Outcome);
      Assert (Outcome = AUnit.Failure, "the inner run passes");
   end Runs_AUnit_In_AUnit;

   overriding procedure Register_Tests (Self : in out Inner_Case) is
      use AUnit.Test_Cases.Registration;
   begin
      Register_Routine (Self, Inner_Passes'Access, "passes");
      Register_Routine (Self, Fails'Access, "fails");
   end Register_Tests;

   overriding function Name (Self : Inner_Case) return AUnit.Message_String is
      pragma Unreferenced (Self);
   begin
      return AUnit.Format ("Inner");
   end Name;

   overriding procedure Register_Tests (Self : in out Descendants_Case) is
      use AUnit.Test_Cases.Registration;
   begin
      Register_Routine (Self, Executes_Itself'Access, "executes_itself");
      Register_Routine (Self, Executes_Itself_Twice'Access, "executes_itself_twice");
      Register_Routine
        (Self, Needs_A_Descendant_That_Fails'Access, "needs_a_descendant_that_fails");
      Register_Routine
        (Self, Expects_A_Descendant_That_Fails'Access, "expects_a_descendant_that_fails");
      Register_Routine
        (Self, Executes_Itself_Without_Environment'Access, "executes_itself_without_environment");
      Register_Routine
        (Self, Expects_A_Failure_Without_Environment'Access,
         "expects_a_failure_without_environment");
      Register_Routine (Self, Spawns_Itself'Access, "spawns_itself");
      Register_Routine
        (Self, Needs_A_Spawned_Descendant_That_Fails'Access,
         "needs_a_spawned_descendant_that_fails");
      Register_Routine
        (Self, Reads_What_A_Descendant_Prints'Access, "reads_what_a_descendant_prints");
      Register_Routine
        (Self, Has_An_Environment_Of_Its_Own'Access, "has_an_environment_of_its_own");
      Register_Routine (Self, Forks_And_Exits'Access, "forks_and_exits");
      Register_Routine (Self, Forks_And_Exits_With_A_Code'Access, "forks_and_exits_with_a_code");
      Register_Routine (Self, Forks_And_Exits_At_Once'Access, "forks_and_exits_at_once");
      Register_Routine (Self, Forks_And_Aborts'Access, "forks_and_aborts");
      Register_Routine (Self, Forks_And_Returns'Access, "forks_and_returns");
      Register_Routine (Self, Forks_And_Fails'Access, "forks_and_fails");
      Register_Routine (Self, Needs_A_Fork_That_Fails'Access, "needs_a_fork_that_fails");
      Register_Routine (Self, Passes'Access, "passes");
      Register_Routine (Self, Fails'Access, "fails");
      Register_Routine (Self, Runs_AUnit_In_AUnit'Access, "runs_aunit_in_aunit");
   end Register_Tests;

   overriding function Name (Self : Descendants_Case) return AUnit.Message_String is
      pragma Unreferenced (Self);
   begin
      return AUnit.Format ("Descendants");
   end Name;

   function Suite return AUnit.Test_Suites.Access_Test_Suite is
      use AUnit.Test_Suites;
      All_Tests : constant Access_Test_Suite := New_Suite;
   begin
      All_Tests.Add_Test (Descendants'Access);
      return All_Tests;
   end Suite;

end Descendants_Tests;
