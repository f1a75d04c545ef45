--  Tests the joint of the robot.

with RobotTestingFramework.TestCase;

package My_Robot_Test is

   --  rtf calls Setup, Run and TearDown, in a separate process for each test.
   type Test is new RobotTestingFramework.TestCase.TestCase with record
      Goal : Long_Float := 0.0;
   end record;

   overriding function Setup (Self : in out Test; Parameters : String) return Boolean;
   overriding procedure Run (Self : in out Test);
   overriding procedure TearDown (Self : in out Test);

   package Plugin is new RobotTestingFramework.TestCase.Register (Test);

end My_Robot_Test;
