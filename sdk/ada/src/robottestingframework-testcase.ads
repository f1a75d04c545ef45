--  SPDX-License-Identifier: Apache-2.0
--  Tests.
--
--     package Move_Test is
--        type Test is new RobotTestingFramework.TestCase.TestCase with null record;
--        overriding procedure Run (Self : in out Test);
--        package Plugin is new RobotTestingFramework.TestCase.Register (Test);
--     end Move_Test;
--
--  The first failure or error decides the verdict. A failure means that the robot
--  is wrong, an error that the bench is; a problem in Setup or TearDown is always
--  an error, and so is an exception.

--  Each plug-in has a copy of this type, and a process may hold several of them. Inside of the
--  package, the pragma would have no effect on the elaboration.
pragma Suppress (Duplicated_Tag_Check);

private with RobotTestingFramework.Registry;

package RobotTestingFramework.TestCase is

   type TestCase is abstract tagged private;
   type TestCase_Access is access all TestCase'Class;

   --  Prepares the test. Parameters is the parameter string in the suite. False means
   --  that the test cannot run.
   function Setup (Self : in out TestCase; Parameters : String) return Boolean;

   --  Runs the test.
   procedure Run (Self : in out TestCase) is abstract;

   --  Restores the initial state. Always called.
   procedure TearDown (Self : in out TestCase) is null;

   --  Declares the plug-in's test.
   generic
      type Test is new TestCase with private;
   package Register is
   private
      procedure Make;
      Registered : constant Boolean := Registry.Register (Make'Access);
   end Register;

   --  The name of a test that has none.
   Unknown : constant String := "Unknown";

   --  Makes this the plug-in's test. Its name in the suite does not change; another name is
   --  reported before Setup.
   procedure SetTest (Test : TestCase_Access; Name : String := Unknown);

   --  Reports the test's own name.
   procedure SetName (Name : String);

   --  Reports the name that SetTest gave the test.
   procedure Report_Name;

   --  The plug-in's test, if it is one.
   function Current return TestCase_Access;

private

   type TestCase is abstract tagged null record;

end RobotTestingFramework.TestCase;
