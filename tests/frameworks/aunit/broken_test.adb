with Ada.Command_Line;
with AUnit.Options;
with AUnit.Reporter.Text;
with AUnit.Test_Filters;
with Broken_Tests;
with RTF_AUnit;

--  The argument is the start of the names of the tests to run.
procedure Broken_Test is
   function Runner is new RTF_AUnit.Test_Runner_With_Status (Broken_Tests.Suite);
   Reporter : AUnit.Reporter.Text.Text_Reporter;
   Filter   : aliased AUnit.Test_Filters.Name_Filter;
   Options  : AUnit.Options.AUnit_Options := AUnit.Options.Default_Options;
   use type AUnit.Status;
begin
   if Ada.Command_Line.Argument_Count > 0 then
      Filter.Set_Name (Ada.Command_Line.Argument (1));
      Options.Filter := Filter'Unchecked_Access;
   end if;
   if Runner (Reporter, Options) = AUnit.Failure then
      Ada.Command_Line.Set_Exit_Status (Ada.Command_Line.Failure);
   end if;
end Broken_Test;
