with RobotTestingFramework.Asserter; use RobotTestingFramework.Asserter;
with RobotTestingFramework.Session; use RobotTestingFramework.Session;

package body Plugin is

   Taken : Natural := 0;

   function Read return Long_Float is
   begin
      Taken := Taken + 1;
      return Long_Float (Taken);
   end Read;

   procedure Sample_Ramp is new Sample_For (Read);

   overriding procedure Run (Self : in out Test) is
   begin
      Sample ("elbow", 0.25, "rad", High => 1.5, Time => 0.5);
      Sample ("current", 2.0, Time => 0.5);
      Sample ("elbow", 1.5, "rad", High => 1.5, Time => 1.0);
      Report ("what was sampled comes before");
      Sample_Ramp ("ramp", 0.05, 20.0);
      Sample ("elbow", 1.75, "rad", -1.5, 1.5, Time => 1.25);
      Sample ("elbow", 2.0, "rad", -1.5, 1.5, Time => 1.5);
   end Run;

end Plugin;
