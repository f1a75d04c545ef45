--  A harness that does not use RTF_AUnit.
with Arm_Suite;
with AUnit.Reporter.Text;
with AUnit.Run;

procedure Plain_Test is
   procedure Runner is new AUnit.Run.Test_Runner (Arm_Suite.Suite);
   Reporter : AUnit.Reporter.Text.Text_Reporter;
begin
   Runner (Reporter);
end Plain_Test;
