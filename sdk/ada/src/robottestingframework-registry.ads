--  SPDX-License-Identifier: Apache-2.0
--  Creates the plug-in's one test or fixture. Plug-ins use TestCase.Register and
--  FixtureManager.Register instead.

package RobotTestingFramework.Registry is

   type Maker is access procedure;

   --  Registers the procedure that creates the test or fixture. Always True: it is
   --  called in a declaration.
   function Register (Make : not null Maker) return Boolean;

   --  Creates the test or fixture with the registered procedure, or with the one that
   --  is exported as Test_Create_Symbol.
   procedure Make;

end RobotTestingFramework.Registry;
