--  Its elaboration raises an exception.

with RobotTestingFramework.TestCase;

package Elaboration is

   type Test is new RobotTestingFramework.TestCase.TestCase with null record;
   overriding procedure Run (Self : in out Test) is null;

   procedure Calibrate;

   package Plugin is new RobotTestingFramework.TestCase.Register (Test);

end Elaboration;
