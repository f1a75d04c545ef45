--  SPDX-License-Identifier: Apache-2.0
--  Tests.
--
--     package Move_Test is
--        type Test is new RobotTestingFramework.TestCase.TestCase with null record;
--        overriding procedure Run (Self : in out Test);
--        package Plugin is new RobotTestingFramework.TestCase.Register (Test);
--     end Move_Test;
--
--  The first failure or error decides the verdict. A failure says that the robot
--  is wrong, an error that the bench is; a problem in Setup or TearDown is always
--  an error, and so is an exception.

private with RobotTestingFramework.Registry;

package RobotTestingFramework.TestCase is

   --  Each plug-in has a copy of this type. A process may hold several of them.
   pragma Suppress (Duplicated_Tag_Check);

   type TestCase is abstract tagged private;
   type TestCase_Access is access all TestCase'Class;

   --  Prepares the test. Parameters is the parameter string as it stands in the
   --  suite. False means that the test cannot be run.
   function Setup (Self : in out TestCase; Parameters : String) return Boolean;

   --  Does the test.
   procedure Run (Self : in out TestCase) is abstract;

   --  Puts back what the test changed. Called whatever happened before.
   procedure TearDown (Self : in out TestCase) is null;

   --  Declares the plug-in's test.
   generic
      type Test is new TestCase with private;
   package Register is
   private
      procedure Make;
      Kept : constant Boolean := Registry.Keep (Make'Access);
   end Register;

   --  Makes this the plug-in's test. The name that the suite gives it stays.
   procedure SetTest (Test : TestCase_Access; Name : String := "Unknown");

   --  Tells what the test calls itself.
   procedure SetName (Name : String);

   --  The plug-in's test, if it is one.
   function Current return TestCase_Access;

private

   type TestCase is abstract tagged null record;

end RobotTestingFramework.TestCase;
