--  SPDX-License-Identifier: Apache-2.0
--  Runs the tests of an AUnit harness as AUnit.Run does, and reports each one to rtf while it
--  runs. A harness uses it instead of AUnit.Run:
--
--     with RTF_AUnit;
--     ...
--     procedure Runner is new RTF_AUnit.Test_Runner (Arm_Suite.Suite);
--
--  If rtf did not start the program, it does the same as AUnit.Run.

with AUnit;
with AUnit.Options;
with AUnit.Reporter;
with AUnit.Test_Results;
with AUnit.Test_Suites;

package RTF_AUnit is

   generic
      with function Suite return AUnit.Test_Suites.Access_Test_Suite;
   procedure Test_Runner
     (Reporter : AUnit.Reporter.Reporter'Class;
      Options  : AUnit.Options.AUnit_Options := AUnit.Options.Default_Options);

   generic
      with function Suite return AUnit.Test_Suites.Access_Test_Suite;
   procedure Test_Runner_With_Results
     (Reporter : AUnit.Reporter.Reporter'Class;
      Results  : in out AUnit.Test_Results.Result'Class;
      Options  : AUnit.Options.AUnit_Options := AUnit.Options.Default_Options);

   generic
      with function Suite return AUnit.Test_Suites.Access_Test_Suite;
   function Test_Runner_With_Status
     (Reporter : AUnit.Reporter.Reporter'Class;
      Options  : AUnit.Options.AUnit_Options := AUnit.Options.Default_Options)
      return AUnit.Status;

   --  The functions above without generics.
   procedure Run
     (Suite    : AUnit.Test_Suites.Access_Test_Suite;
      Reporter : AUnit.Reporter.Reporter'Class;
      Results  : in out AUnit.Test_Results.Result'Class;
      Options  : AUnit.Options.AUnit_Options;
      Outcome  : out AUnit.Status);

end RTF_AUnit;
