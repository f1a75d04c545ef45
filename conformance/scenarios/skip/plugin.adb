with RobotTestingFramework.Asserter; use RobotTestingFramework.Asserter;

package body Plugin is

   overriding procedure Run (Self : in out Test) is
   begin
      Report ("before");
      Skip ("no camera");
      Report ("after");
   end Run;

   overriding procedure TearDown (Self : in out Test) is
   begin
      Report ("torn down");
   end TearDown;

end Plugin;
