with RobotTestingFramework.Asserter;
with RobotTestingFramework.Faults;

package body Plugin is

   overriding procedure Run (Self : in out Test) is
   begin
      RobotTestingFramework.Faults.Inject ("drop");
      RobotTestingFramework.Asserter.Report ("not reached");
   end Run;

end Plugin;
