with Arm_Suite;
with AUnit.Reporter.Text;
with RTF_AUnit;

procedure Arm_Test is
   procedure Runner is new RTF_AUnit.Test_Runner (Arm_Suite.Suite);
   Reporter : AUnit.Reporter.Text.Text_Reporter;
begin
   Runner (Reporter);
end Arm_Test;
