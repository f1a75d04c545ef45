with RobotTestingFramework.Asserter; use RobotTestingFramework.Asserter;

package body Plugin is

   overriding procedure Run (Self : in out Test) is
      procedure C_Abort with Import, Convention => C, External_Name => "abort";
   begin
      Report ("before the abort");
      C_Abort;
   end Run;

end Plugin;
