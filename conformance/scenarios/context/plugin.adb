with RobotTestingFramework.Asserter; use RobotTestingFramework.Asserter;
with RobotTestingFramework.Session;  use RobotTestingFramework.Session;

package body Plugin is

   overriding procedure Run (Self : in out Test) is
   begin
      Report (Name & " " & Parameters & " " & Environment & Repetition'Image);
   end Run;

end Plugin;
