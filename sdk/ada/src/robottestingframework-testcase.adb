--  SPDX-License-Identifier: Apache-2.0

with Ada.Strings.Unbounded; use Ada.Strings.Unbounded;
with RobotTestingFramework.Asserter;
with RobotTestingFramework.Entry_Point;
pragma Unreferenced (RobotTestingFramework.Entry_Point);
with RobotTestingFramework.Session;

package body RobotTestingFramework.TestCase is

   Instance : TestCase_Access;
   Own_Name : Unbounded_String;
   --  The last name that was reported.
   Reported : Unbounded_String;

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

   procedure SetTest (Test : TestCase_Access; Name : String := Unknown) is
   begin
      Instance := Test;
      Own_Name := To_Unbounded_String (Name);
      Reported := Null_Unbounded_String;
   end SetTest;

   procedure SetName (Name : String) is
   begin
      if Name /= Session.Name and then Reported /= Name then
         Asserter.TestReport ("test name: " & Name);
         Reported := To_Unbounded_String (Name);
      end if;
   end SetName;

   procedure Report_Name is
   begin
      if Own_Name /= Unknown then
         SetName (To_String (Own_Name));
      end if;
   end Report_Name;

   function Current return TestCase_Access is (Instance);

end RobotTestingFramework.TestCase;
