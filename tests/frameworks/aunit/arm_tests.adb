with Ada.Text_IO;
with AUnit.Assertions; use AUnit.Assertions;
with RTF_Session;

package body Arm_Tests is

   use AUnit.Test_Cases;

   Robot_Error : exception;

   Position : Integer := 0;

   subtype Joint is Positive range 1 .. 6;

   procedure Passes (Self : in out Test_Case'Class);
   procedure Fails (Self : in out Test_Case'Class);
   procedure Fails_Twice (Self : in out Test_Case'Class);
   procedure Raises (Self : in out Test_Case'Class);
   procedure Is_Out_Of_Range (Self : in out Test_Case'Class);
   procedure Prints (Self : in out Test_Case'Class);
   procedure Measures (Self : in out Test_Case'Class);

   procedure Passes (Self : in out Test_Case'Class) is
      pragma Unreferenced (Self);
   begin
      Assert (Position = 41, "at home");
   end Passes;

   procedure Fails (Self : in out Test_Case'Class) is
      pragma Unreferenced (Self);
   begin
      Assert (Position = 42, "the arm ""left"" <home> & ü stays"); -- line: fails
   end Fails;

   procedure Fails_Twice (Self : in out Test_Case'Class) is
      pragma Unreferenced (Self);
   begin
      if Assert (False, "first") or else Assert (False, "second") then -- line: fails twice
         null;
      end if;
   end Fails_Twice;

   procedure Raises (Self : in out Test_Case'Class) is
      pragma Unreferenced (Self);
   begin
      raise Robot_Error with "no power";
   end Raises;

   procedure Is_Out_Of_Range (Self : in out Test_Case'Class) is
      pragma Unreferenced (Self);
      Number : Joint := Joint'First;
   begin
      Number := Position; -- line: out of range
      Ada.Text_IO.Put_Line (Number'Image);
   end Is_Out_Of_Range;

   procedure Prints (Self : in out Test_Case'Class) is
      pragma Unreferenced (Self);
   begin
      Ada.Text_IO.Put ("on stdout, no newline");
      Ada.Text_IO.Put_Line (Ada.Text_IO.Standard_Error, "on stderr");
   end Prints;

   procedure Measures (Self : in out Test_Case'Class) is
      pragma Unreferenced (Self);
   begin
      Assert (RTF_Session.Measure ("settling time", 0.1, "s", 0.0, 0.8), "fast");
      RTF_Session.Report ("a ""text"" with " & Character'Val (16#FC#) & ASCII.LF);
      RTF_Session.Attach ("/proc/self/status", "status.txt", "text/plain");
      RTF_Session.Attach ("/nowhere/trace.csv");
      Assert (RTF_Session.Measure ("effort", 3.0, "Nm", High => 2.5), "strong");
   end Measures;

   overriding procedure Register_Tests (Self : in out Arm_Case) is
      use AUnit.Test_Cases.Registration;
   begin
      Register_Routine (Self, Passes'Access, "passes");
      Register_Routine (Self, Fails'Access, "fails");
      Register_Routine (Self, Fails_Twice'Access, "fails twice");
      Register_Routine (Self, Raises'Access, "raises");
      Register_Routine (Self, Is_Out_Of_Range'Access, "is out of range");
      Register_Routine (Self, Prints'Access, "prints");
      Register_Routine (Self, Measures'Access, "measures");
      Register_Routine (Self, Passes'Access, "a, ""b"" 'c' <d> & [e]/{f} (g) ünï 😀");
      Register_Routine (Self, Passes'Access, "same");
      Register_Routine (Self, Passes'Access, "same");
   end Register_Tests;

   overriding procedure Set_Up (Self : in out Arm_Case) is
      pragma Unreferenced (Self);
   begin
      Position := 41;
   end Set_Up;

   overriding function Name (Self : Arm_Case) return AUnit.Message_String is
      pragma Unreferenced (Self);
   begin
      return AUnit.Format ("Arm");
   end Name;

   overriding procedure Register_Tests (Self : in out Bench_Case) is
      use AUnit.Test_Cases.Registration;
   begin
      Register_Routine (Self, Passes'Access, "first");
      Register_Routine (Self, Passes'Access, "second");
   end Register_Tests;

   overriding procedure Set_Up_Case (Self : in out Bench_Case) is
      pragma Unreferenced (Self);
   begin
      raise Robot_Error with "no bench";
   end Set_Up_Case;

   overriding function Name (Self : Bench_Case) return AUnit.Message_String is
      pragma Unreferenced (Self);
   begin
      return AUnit.Format ("Bench");
   end Name;

   overriding procedure Set_Up (Self : in out Gripper) is
   begin
      Self.Fingers := 3;
   end Set_Up;

   procedure Opens (Self : in out Gripper) is
   begin
      Assert (Self.Fingers = 3, "three fingers");
   end Opens;

   procedure Closes (Self : in out Gripper) is
   begin
      Assert (Self.Fingers = 2, "two fingers"); -- line: two fingers
   end Closes;

end Arm_Tests;
