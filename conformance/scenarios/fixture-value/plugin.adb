with Ada.Environment_Variables;
with RobotTestingFramework.Asserter; use RobotTestingFramework.Asserter;
with RobotTestingFramework.Session;  use RobotTestingFramework.Session;

package body Plugin is

   overriding procedure Run (Self : in out Test) is
      Values : constant String :=
        Fixture_Value ("simulator.port") & " " & Fixture_Value ("simulator.model") & " "
        & Fixture_Value ("simulator.ready") & " " & Fixture_Value ("simulator.limits");
   begin
      if Values /= "40123 arm true [-1.5,1.5]" then
         Fail ("wrong values: " & Values);
      elsif Ada.Environment_Variables.Value ("RTF_FIXTURE_SIMULATOR_PORT", "") /= "40123" then
         Fail ("wrong port in the environment");
      end if;
      Report ("values read");
   end Run;

end Plugin;
