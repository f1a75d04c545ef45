with RobotTestingFramework; use RobotTestingFramework;
with RobotTestingFramework.Asserter;

package body Predecessor is

   procedure Create is
   begin
      SetTest (new MyTest, "AdaTest");
   end Create;

   overriding function Setup (Self : in out MyTest; Parameters : String) return Boolean is
      pragma Unreferenced (Self);
   begin
      SetName ("MyTest");
      Asserter.TestReport ("setup: " & Parameters);
      return True;
   end Setup;

   overriding procedure TearDown (Self : in out MyTest) is
      pragma Unreferenced (Self);
   begin
      Asserter.TestReport ("torn down");
   end TearDown;

   overriding procedure Run (Self : in out MyTest) is
      pragma Unreferenced (Self);
   begin
      Asserter.TestCheck (True, "checked 100% %s");
      Asserter.TestCheck (False, "not so");
      Asserter.TestFailIf (True, "silent");
      Asserter.TestFailIf (False, "loud");
      Asserter.FailIf (True, "silent");
      Asserter.ErrorIf (True, "silent");
      Asserter.FailIf (False, "the end");
      Asserter.TestReport ("unreachable");
   end Run;

end Predecessor;
