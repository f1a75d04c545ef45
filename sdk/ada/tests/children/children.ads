--  A test that starts a process in the way that its second argument names, and reports how the
--  process ended.

with RobotTestingFramework.TestCase;

package Children is

   type Test is new RobotTestingFramework.TestCase.TestCase with null record;
   overriding procedure Run (Self : in out Test);

   package Plugin is new RobotTestingFramework.TestCase.Register (Test);

end Children;
