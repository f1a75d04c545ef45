--  A test as it was written for robot-testing-framework 2.x.

with RobotTestingFramework.TestCase; use RobotTestingFramework.TestCase;

package Predecessor is

   type MyTest is new TestCase with null record;

   overriding function Setup (Self : in out MyTest; Parameters : String) return Boolean;
   overriding procedure TearDown (Self : in out MyTest);
   overriding procedure Run (Self : in out MyTest);

   procedure Create;
   pragma Export (C, Create, RobotTestingFramework.Test_Create_Symbol);

end Predecessor;
