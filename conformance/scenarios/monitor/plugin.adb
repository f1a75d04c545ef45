with RobotTestingFramework.Session; use RobotTestingFramework.Session;

package body Plugin is

   overriding procedure Run (Self : in out Test) is
   begin
      Sample ("level", 5.0, "m");
      Monitor ("always(level < 2m)", "low");
      Monitor ("always(level > 0m)", Meaning => Stop);
      Monitor ("always(level < 2kg)", "wrong unit", Error);
      Sample ("level", 1.0, "m");
      Sample ("level", 3.0, "m");
   end Run;

end Plugin;
