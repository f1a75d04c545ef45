with Ada.Command_Line;
with AUnit; use AUnit;
with AUnit.Reporter.Text;
with Descendants_Tests;
with RTF_AUnit;

procedure Descendants_Test is
   function Runner is new RTF_AUnit.Test_Runner_With_Status (Descendants_Tests.Suite);
   Reporter : AUnit.Reporter.Text.Text_Reporter;
begin
   Ada.Command_Line.Set_Exit_Status (if Runner (Reporter) = Success then 0 else 1);
end Descendants_Test;
