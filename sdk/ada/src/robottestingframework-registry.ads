--  SPDX-License-Identifier: Apache-2.0
--  How the plug-in's one test or fixture is made. Plug-ins use TestCase.Register
--  and FixtureManager.Register instead.

package RobotTestingFramework.Registry is

   type Maker is access procedure;

   --  Keeps the procedure that makes the test or fixture. Always True: it is
   --  called where only a declaration may stand.
   function Keep (Make : not null Maker) return Boolean;

   --  Makes the test or fixture, by the procedure that was kept or by the one
   --  that is exported as Test_Create_Symbol.
   procedure Make;

end RobotTestingFramework.Registry;
