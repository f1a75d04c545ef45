with RobotTestingFramework.Asserter; use RobotTestingFramework.Asserter;
with RobotTestingFramework.Session;

package body Plugin is

   overriding procedure Run (Self : in out Test) is
      One : constant Positive := RobotTestingFramework.Session.Repetition;
   begin
      Report ("hello");
      Check (One = 1, "one is one");
   end Run;

   overriding procedure TearDown (Self : in out Test) is
   begin
      Report ("torn down");
   end TearDown;

end Plugin;
