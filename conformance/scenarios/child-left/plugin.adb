with Interfaces.C; use Interfaces.C;
with RobotTestingFramework.Asserter; use RobotTestingFramework.Asserter;

package body Plugin is

   overriding procedure Run (Self : in out Test) is
      function Shell (Command : char_array) return int
        with Import, Convention => C, External_Name => "system";
      Script : constant String := "setsid bash -c 'exec -a rtf-left-behind sleep 1000' & "
        & "until grep -qa ^rtf-left-behind /proc/$!/cmdline; do :; done";
   begin
      ErrorIf (Shell (To_C (Script)) = 0, "a shell");
      Report ("child started");
   end Run;

end Plugin;
