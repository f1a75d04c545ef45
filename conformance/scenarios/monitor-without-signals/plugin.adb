with RobotTestingFramework.Session; use RobotTestingFramework.Session;

package body Plugin is

   overriding procedure Run (Self : in out Test) is
   begin
      Monitor ("always(level < 2m)");
   end Run;

end Plugin;
