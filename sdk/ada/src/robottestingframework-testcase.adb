--  SPDX-License-Identifier: Apache-2.0

with RobotTestingFramework.Asserter;
with RobotTestingFramework.Entry_Point;
pragma Unreferenced (RobotTestingFramework.Entry_Point);
with RobotTestingFramework.Session;

package body RobotTestingFramework.TestCase is

   Instance : TestCase_Access;

   function Setup (Self : in out TestCase; Parameters : String) return Boolean is
      pragma Unreferenced (Self, Parameters);
   begin
      return True;
   end Setup;

   package body Register is
      procedure Make is
      begin
         SetTest (new Test);
      end Make;
   end Register;

   procedure SetTest (Test : TestCase_Access; Name : String := "Unknown") is
      pragma Unreferenced (Name);
   begin
      Instance := Test;
   end SetTest;

   procedure SetName (Name : String) is
   begin
      if Name /= Session.Name then
         Asserter.TestReport ("test name: " & Name);
      end if;
   end SetName;

   function Current return TestCase_Access is (Instance);

end RobotTestingFramework.TestCase;
