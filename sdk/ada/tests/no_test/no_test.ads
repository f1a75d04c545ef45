--  Does not register its test.

with RobotTestingFramework.TestCase;

package No_Test is

   type Test is new RobotTestingFramework.TestCase.TestCase with null record;
   overriding procedure Run (Self : in out Test) is null;

end No_Test;
