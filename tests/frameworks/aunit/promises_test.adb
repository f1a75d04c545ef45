with AUnit.Reporter.Text;
with Promises_Tests;
with RTF_AUnit;

procedure Promises_Test is
   procedure Runner is new RTF_AUnit.Test_Runner (Promises_Tests.Suite);
   Reporter : AUnit.Reporter.Text.Text_Reporter;
begin
   Runner (Reporter);
end Promises_Test;
