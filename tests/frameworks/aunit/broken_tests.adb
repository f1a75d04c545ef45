with Ada.Text_IO;
with AUnit.Assertions; use AUnit.Assertions;
with Interfaces.C;

package body Broken_Tests is

   use AUnit.Test_Cases;

   --  GNAT handles the signals of crashes, but not SIGKILL.
   function C_Raise (Signal : Interfaces.C.int) return Interfaces.C.int
     with Import, Convention => C, External_Name => "raise";
   procedure C_Exit (Code : Interfaces.C.int)
     with Import, Convention => C, External_Name => "exit";

   Tear_Down_Fails : Boolean := False;

   procedure Passes (Self : in out Test_Case'Class) is null;
   procedure Crashes (Self : in out Test_Case'Class);
   procedure Reads_Nothing (Self : in out Test_Case'Class);
   procedure Fails (Self : in out Test_Case'Class);
   procedure Hangs (Self : in out Test_Case'Class);
   procedure Exits (Self : in out Test_Case'Class);
   procedure Breaks_Tear_Down (Self : in out Test_Case'Class);

   procedure Crashes (Self : in out Test_Case'Class) is
      Done : Interfaces.C.int;
      pragma Unreferenced (Self, Done);
   begin
      Ada.Text_IO.Put_Line ("before the crash");
      Done := C_Raise (9);
   end Crashes;

   procedure Reads_Nothing (Self : in out Test_Case'Class) is
      pragma Unreferenced (Self);
      type Access_Integer is access all Integer;
      Nothing : Access_Integer;
      pragma Volatile (Nothing);
      pragma Suppress (Access_Check);
   begin
      Nothing := null;
      Assert (Nothing.all = 1, "never");
   end Reads_Nothing;

   procedure Fails (Self : in out Test_Case'Class) is
      pragma Unreferenced (Self);
   begin
      Assert (False, "after the crash"); -- line: fails
   end Fails;

   procedure Hangs (Self : in out Test_Case'Class) is
      pragma Unreferenced (Self);
   begin
      delay 100_000.0;
   end Hangs;

   procedure Exits (Self : in out Test_Case'Class) is
      pragma Unreferenced (Self);
   begin
      C_Exit (0);
   end Exits;

   procedure Breaks_Tear_Down (Self : in out Test_Case'Class) is
      pragma Unreferenced (Self);
   begin
      Tear_Down_Fails := True;
   end Breaks_Tear_Down;

   overriding procedure Register_Tests (Self : in out Broken_Case) is
      use AUnit.Test_Cases.Registration;
   begin
      Register_Routine (Self, Passes'Access, "passes");
      Register_Routine (Self, Crashes'Access, "crashes");
      Register_Routine (Self, Reads_Nothing'Access, "reads nothing");
      Register_Routine (Self, Fails'Access, "fails");
      Register_Routine (Self, Hangs'Access, "hangs");
      Register_Routine (Self, Exits'Access, "exits");
      Register_Routine (Self, Breaks_Tear_Down'Access, "breaks tear-down");
      Register_Routine (Self, Passes'Access, "after all");
   end Register_Tests;

   overriding procedure Tear_Down (Self : in out Broken_Case) is
      pragma Unreferenced (Self);
   begin
      if Tear_Down_Fails then
         raise Program_Error with "the brake is stuck";
      end if;
   end Tear_Down;

   overriding function Name (Self : Broken_Case) return AUnit.Message_String is
      pragma Unreferenced (Self);
   begin
      return AUnit.Format ("Broken");
   end Name;

   Broken : aliased Broken_Case;

   function Suite return AUnit.Test_Suites.Access_Test_Suite is
      use AUnit.Test_Suites;
      All_Tests : constant Access_Test_Suite := New_Suite;
   begin
      All_Tests.Add_Test (Broken'Access);
      return All_Tests;
   end Suite;

end Broken_Tests;
