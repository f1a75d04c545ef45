--  SPDX-License-Identifier: Apache-2.0
--  Reports each test routine as a case, and does not run those that rtf does not select.

with AUnit;
with AUnit.Options;
with AUnit.Test_Results;
with AUnit.Test_Suites;

package RTF_AUnit_Cases is

   --  Whether this run reports to rtf. One in a routine, or in a forked process, does not.
   function Is_Available return Boolean;

   --  Runs a suite. All results are also added to Results.
   procedure Run
     (Suite   : AUnit.Test_Suites.Access_Test_Suite;
      Results : in out AUnit.Test_Results.Result'Class;
      Options : AUnit.Options.AUnit_Options;
      Outcome : out AUnit.Status);

end RTF_AUnit_Cases;
