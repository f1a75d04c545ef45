with RobotTestingFramework.Session; use RobotTestingFramework.Session;

package body Plugin is

   overriding procedure Run (Self : in out Test) is
   begin
      Measure ("position error", 0.02, "rad", High => 0.05);
      Measure ("rate", 87.5, "Hz", 95.0, 105.0);
   end Run;

end Plugin;
