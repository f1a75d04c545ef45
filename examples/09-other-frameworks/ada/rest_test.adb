with AUnit.Reporter.Text;
with Rest_Tests;
with RTF_AUnit;

procedure Rest_Test is
   procedure Runner is new RTF_AUnit.Test_Runner (Rest_Tests.Suite);
   Reporter : AUnit.Reporter.Text.Text_Reporter;
begin
   Runner (Reporter);
end Rest_Test;
