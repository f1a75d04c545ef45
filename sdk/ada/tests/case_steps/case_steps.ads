--  A test with cases, which its first argument names.

with RobotTestingFramework.TestCase;

package Case_Steps is

   type Test is new RobotTestingFramework.TestCase.TestCase with null record;
   overriding procedure Run (Self : in out Test);
   overriding procedure TearDown (Self : in out Test);

   package Plugin is new RobotTestingFramework.TestCase.Register (Test);

end Case_Steps;
