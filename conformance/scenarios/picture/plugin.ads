with RobotTestingFramework.TestCase;

package Plugin is

   type Test is new RobotTestingFramework.TestCase.TestCase with null record;
   overriding procedure Run (Self : in out Test);

   package Declared is new RobotTestingFramework.TestCase.Register (Test);

end Plugin;
