--  SPDX-License-Identifier: Apache-2.0

with AUnit.Time_Measure;
with RTF_AUnit_Cases;

package body RTF_AUnit is

   procedure Run
     (Suite    : AUnit.Test_Suites.Access_Test_Suite;
      Reporter : AUnit.Reporter.Reporter'Class;
      Results  : in out AUnit.Test_Results.Result'Class;
      Options  : AUnit.Options.AUnit_Options;
      Outcome  : out AUnit.Status)
   is
      Time : AUnit.Time_Measure.Time;
   begin
      if Options.Global_Timer then
         AUnit.Time_Measure.Start_Measure (Time);
      end if;
      if RTF_AUnit_Cases.Is_Available then
         RTF_AUnit_Cases.Run (Suite, Results, Options, Outcome);
      else
         AUnit.Test_Suites.Run (Suite, Options, Results, Outcome);
      end if;
      if Options.Global_Timer then
         AUnit.Time_Measure.Stop_Measure (Time);
         AUnit.Test_Results.Set_Elapsed (Results, Time);
      end if;
      AUnit.Reporter.Report (Reporter, Results, Options);
   end Run;

   procedure Test_Runner
     (Reporter : AUnit.Reporter.Reporter'Class;
      Options  : AUnit.Options.AUnit_Options := AUnit.Options.Default_Options)
   is
      Results : AUnit.Test_Results.Result;
      Outcome : AUnit.Status;
   begin
      Run (Suite, Reporter, Results, Options, Outcome);
   end Test_Runner;

   procedure Test_Runner_With_Results
     (Reporter : AUnit.Reporter.Reporter'Class;
      Results  : in out AUnit.Test_Results.Result'Class;
      Options  : AUnit.Options.AUnit_Options := AUnit.Options.Default_Options)
   is
      Outcome : AUnit.Status;
   begin
      Run (Suite, Reporter, Results, Options, Outcome);
   end Test_Runner_With_Results;

   function Test_Runner_With_Status
     (Reporter : AUnit.Reporter.Reporter'Class;
      Options  : AUnit.Options.AUnit_Options := AUnit.Options.Default_Options)
      return AUnit.Status
   is
      Results : AUnit.Test_Results.Result;
      Outcome : AUnit.Status;
   begin
      Run (Suite, Reporter, Results, Options, Outcome);
      return Outcome;
   end Test_Runner_With_Status;

end RTF_AUnit;
