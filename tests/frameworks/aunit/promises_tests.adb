with Ada.Environment_Variables;
with AUnit.Assertions; use AUnit.Assertions;
with Interfaces.C; use Interfaces.C;
with RTF_Session;

package body Promises_Tests is

   use AUnit.Test_Cases;

   Promises : aliased Promises_Case;

   function Run_Shell (Command : char_array) return int
   with Import, Convention => C, External_Name => "system";

   procedure First (Self : in out Test_Case'Class);
   procedure Second (Self : in out Test_Case'Class);
   procedure Third (Self : in out Test_Case'Class);

   procedure First (Self : in out Test_Case'Class) is null;

   procedure Second (Self : in out Test_Case'Class) is
      pragma Unreferenced (Self);
      Command : constant String := Ada.Environment_Variables.Value ("PROMISE");
   begin
      Assert (Run_Shell (To_C (Command)) = 0, "the command fails");
   end Second;

   procedure Third (Self : in out Test_Case'Class) is
      pragma Unreferenced (Self);
      use Ada.Environment_Variables;
   begin
      if Exists ("MEASURES") then
         RTF_Session.Measure ("force", 2.5, "N", 0.0, Long_Float'Value (Value ("MEASURES")));
      end if;
   end Third;

   overriding procedure Register_Tests (Self : in out Promises_Case) is
      use AUnit.Test_Cases.Registration;
   begin
      Register_Routine (Self, First'Access, "first");
      Register_Routine (Self, Second'Access, "second");
      Register_Routine (Self, Third'Access, "third");
   end Register_Tests;

   overriding function Name (Self : Promises_Case) return AUnit.Message_String is
      pragma Unreferenced (Self);
   begin
      return AUnit.Format ("Promises");
   end Name;

   function Suite return AUnit.Test_Suites.Access_Test_Suite is
      use AUnit.Test_Suites;
      All_Tests : constant Access_Test_Suite := New_Suite;
   begin
      All_Tests.Add_Test (Promises'Access);
      return All_Tests;
   end Suite;

end Promises_Tests;
