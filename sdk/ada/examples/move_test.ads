--  Moves a joint to the goal that the suite gives.

with RobotTestingFramework.TestCase;

package Move_Test is

   type Test is new RobotTestingFramework.TestCase.TestCase with record
      Goal     : Long_Float := 0.5;
      Position : Long_Float := 0.0;
   end record;

   overriding function Setup (Self : in out Test; Parameters : String) return Boolean;
   overriding procedure Run (Self : in out Test);
   overriding procedure TearDown (Self : in out Test);

   package Plugin is new RobotTestingFramework.TestCase.Register (Test);

end Move_Test;
