--  SPDX-License-Identifier: Apache-2.0
--  AUnit asks a filter before each routine, which starts a case. It reports the result before
--  the tear-down of the routine, so a case finishes when the next one starts or the run ends.

with Ada.Containers.Indefinite_Hashed_Maps;
with Ada.Containers.Indefinite_Hashed_Sets;
with Ada.Strings.Fixed;
with Ada.Strings.Hash;
with Ada.Strings.Maps;
with Ada.Strings.Unbounded;
with Ada_Containers;
with AUnit.Simple_Test_Cases;
with AUnit.Test_Filters;
with AUnit.Tests;
with AUnit.Time_Measure;
with Interfaces.C_Streams;
with RTF_Session;
with System;

package body RTF_AUnit_Cases is

   use Ada.Strings.Unbounded;
   use AUnit;
   use AUnit.Test_Results;
   use type AUnit.Test_Filters.Test_Filter_Access;
   use type System.Address;
   use RTF_Session;

   package Name_Counts is new Ada.Containers.Indefinite_Hashed_Maps
     (String, Positive, Ada.Strings.Hash, "=");
   package Name_Sets is new Ada.Containers.Indefinite_Hashed_Sets
     (String, Ada.Strings.Hash, "=");

   --  Asks the filter of the harness.
   type Filter_Of_User is abstract new AUnit.Test_Filters.Test_Filter with record
      Inner : AUnit.Test_Filters.Test_Filter_Access;
   end record;

   function Is_Selected
     (Self : Filter_Of_User'Class; Test : AUnit.Tests.Test'Class) return Boolean
   is
     (Self.Inner = null or else AUnit.Test_Filters.Is_Active (Self.Inner.all, Test));

   --  Collects the names of all routines, and runs none.
   type Planner is new Filter_Of_User with null record;
   overriding function Is_Active
     (Filter : Planner; T : AUnit.Tests.Test'Class) return Boolean;

   --  Starts cases.
   type Starter is new Filter_Of_User with null record;
   overriding function Is_Active
     (Filter : Starter; T : AUnit.Tests.Test'Class) return Boolean;

   --  Reports results, and passes them on.
   type Reporting_Result (Target : not null access Result'Class) is new Result with null record;
   overriding procedure Add_Error
     (R            : in out Reporting_Result;
      Test_Name    : Message_String;
      Routine_Name : Message_String;
      Error        : Test_Error;
      Elapsed      : Time_Measure.Time);
   overriding procedure Add_Failure
     (R            : in out Reporting_Result;
      Test_Name    : Message_String;
      Routine_Name : Message_String;
      Failure      : Test_Failure;
      Elapsed      : Time_Measure.Time);
   overriding procedure Add_Success
     (R            : in out Reporting_Result;
      Test_Name    : Message_String;
      Routine_Name : Message_String;
      Elapsed      : Time_Measure.Time);
   overriding procedure Start_Test
     (R : in out Reporting_Result; Subtest_Count : Ada_Containers.Count_Type);

   --  A routine that has the name of an earlier one gets a number.
   Planned_Names : Name_Counts.Map;
   Started_Names : Name_Counts.Map;
   Planned       : Name_Sets.Set;
   --  Planned names that were not sent, as JSON.
   Unsent        : Unbounded_String;

   Is_Running    : Boolean := False;

   --  The path of the open case; empty if there is none.
   Open_Case     : Unbounded_String;
   --  AUnit asks twice before some routines: the test that it asked for, until it starts.
   Asked_Test    : System.Address := System.Null_Address;

   --  All subprograms are declared first: harnesses compile this with their style checks (-gnaty).

   function Text (Value : Message_String) return String is
     (if Value = null then "" else Value.all);

   function Name_Of (Test : AUnit.Tests.Test'Class) return String;
   function Unique (Name : String; Counts : in out Name_Counts.Map) return String;
   procedure Plan (Name : String);
   procedure Send_Plan;
   procedure Finish_Case;

   --  The field of a location; empty if it is unknown.
   function Location (File : String; Line : Natural) return String;

   --  The location in the message of a failed check of the compiler: `arm.adb:12 range …`.
   function Location_In (Message : String) return String;

   --  Sends a message of the open case.
   procedure Send_In_Case (Kind : String; Text : String; Location : String);

   function Name_Of (Test : AUnit.Tests.Test'Class) return String is
      use AUnit.Simple_Test_Cases;
   begin
      if Test not in Test_Case'Class then
         return "unnamed";
      end if;
      declare
         Name    : constant String := Text (Test_Case'Class (Test).Name);
         Routine : constant String := Text (Test_Case'Class (Test).Routine_Name);
      begin
         return (if Name = "" and then Routine = "" then "unnamed"
                 elsif Routine = "" then Name
                 elsif Name = "" then Routine
                 else Name & ": " & Routine);
      end;
   end Name_Of;

   function Unique (Name : String; Counts : in out Name_Counts.Map) return String is
      Count : constant Positive :=
        (if Counts.Contains (Name) then Counts.Element (Name) + 1 else 1);
   begin
      Counts.Include (Name, Count);
      return (if Count = 1 then Name
              else Name & " #" & Ada.Strings.Fixed.Trim (Count'Image, Ada.Strings.Both));
   end Unique;

   procedure Plan (Name : String) is
   begin
      Planned.Include (Name);
      if Length (Unsent) > 32 * 1024 then
         Send_Plan;
      end if;
      if Length (Unsent) > 0 then
         Append (Unsent, ",");
      end if;
      Append (Unsent, Quoted (Name));
   end Plan;

   procedure Send_Plan is
   begin
      if Length (Unsent) > 0 then
         Send ("cases-planned", """names"":[" & To_String (Unsent) & "]");
         Unsent := Null_Unbounded_String;
      end if;
   end Send_Plan;

   procedure Finish_Case is
      use Interfaces.C_Streams;
      Done : int;
      pragma Unreferenced (Done);
   begin
      if Length (Open_Case) > 0 and then not Is_Forked then
         Done := fflush (stdout);
         Send ("case-finished", """name"":" & Quoted (To_String (Open_Case)));
         Open_Case := Null_Unbounded_String;
      end if;
   end Finish_Case;

   overriding function Is_Active
     (Filter : Planner; T : AUnit.Tests.Test'Class) return Boolean is
   begin
      if Is_Selected (Filter, T) then
         Plan (Unique (Name_Of (T), Planned_Names));
      end if;
      return False;
   end Is_Active;

   overriding function Is_Active
     (Filter : Starter; T : AUnit.Tests.Test'Class) return Boolean is
   begin
      if T'Address = Asked_Test then
         return True;
      end if;
      Finish_Case;
      if Is_Forked or else not Is_Selected (Filter, T) then
         --  A forked process starts and finishes no case.
         return Is_Selected (Filter, T);
      end if;
      declare
         Name : constant String := Unique (Name_Of (T), Started_Names);
      begin
         if not Planned.Contains (Name) then
            Plan (Name);
            Send_Plan;
         end if;
         if Exchange ("case-started", """name"":" & Quoted (Name)) = "1" then
            return False;
         end if;
         Open_Case  := To_Unbounded_String (Name);
         Asked_Test := T'Address;
         return True;
      end;
   end Is_Active;

   overriding procedure Start_Test
     (R : in out Reporting_Result; Subtest_Count : Ada_Containers.Count_Type) is
   begin
      Asked_Test := System.Null_Address;
      R.Target.Start_Test (Subtest_Count);
   end Start_Test;

   overriding procedure Add_Success
     (R            : in out Reporting_Result;
      Test_Name    : Message_String;
      Routine_Name : Message_String;
      Elapsed      : Time_Measure.Time) is
   begin
      R.Target.Add_Success (Test_Name, Routine_Name, Elapsed);
   end Add_Success;

   overriding procedure Add_Failure
     (R            : in out Reporting_Result;
      Test_Name    : Message_String;
      Routine_Name : Message_String;
      Failure      : Test_Failure;
      Elapsed      : Time_Measure.Time) is
   begin
      Send_In_Case
        ("failure", Text (Failure.Message), Location (Text (Failure.Source_Name), Failure.Line));
      R.Target.Add_Failure (Test_Name, Routine_Name, Failure, Elapsed);
   end Add_Failure;

   overriding procedure Add_Error
     (R            : in out Reporting_Result;
      Test_Name    : Message_String;
      Routine_Name : Message_String;
      Error        : Test_Error;
      Elapsed      : Time_Measure.Time)
   is
      Message   : constant String := Text (Error.Exception_Message);
      Traceback : constant String :=
        Ada.Strings.Fixed.Trim
          (Text (Error.Traceback), Ada.Strings.Maps.Null_Set,
           Ada.Strings.Maps.To_Set (ASCII.LF));
   begin
      --  Also the result of a failed Set_Up_Case, after which the routine is not started.
      Asked_Test := System.Null_Address;
      Send_In_Case
        ("error",
         Text (Error.Exception_Name) & (if Message = "" then "" else ": " & Message),
         Location_In (Message));
      if Traceback /= "" then
         Send_In_Case ("report", Traceback, "");
      end if;
      R.Target.Add_Error (Test_Name, Routine_Name, Error, Elapsed);
   end Add_Error;

   procedure Send_In_Case (Kind : String; Text : String; Location : String) is
   begin
      --  Without rtf, only the program that runs the tests has a result.
      Send_Message
        ((if Is_Forked then "report" else Kind),
         (if Is_Forked then "in a forked process: " else "") & Text,
         (if Length (Open_Case) = 0 then ""
          else ",""case"":" & Quoted (To_String (Open_Case))) & Location);
   end Send_In_Case;

   function Location (File : String; Line : Natural) return String is
     (if File = "" then ""
      else ",""location"":{""file"":" & Quoted (File) & ",""line"":"
           & Ada.Strings.Fixed.Trim (Line'Image, Ada.Strings.Both) & "}");

   function Location_In (Message : String) return String is
      use Ada.Strings.Fixed;
      Blank : constant Natural := Index (Message, " ");
      Colon : constant Natural := Index (Message, ":");
   begin
      if Colon < 5 or else Blank <= Colon + 1
        or else Message (Colon - 4 .. Colon - 1) not in ".adb" | ".ads"
        or else (for some Digit of Message (Colon + 1 .. Blank - 1) => Digit not in '0' .. '9')
      then
         return "";
      end if;
      return Location
        (Message (Message'First .. Colon - 1), Natural'Value (Message (Colon + 1 .. Blank - 1)));
   end Location_In;

   function Is_Available return Boolean is (Is_Open and then not (Is_Running or Is_Forked));

   procedure Run
     (Suite   : AUnit.Test_Suites.Access_Test_Suite;
      Results : in out AUnit.Test_Results.Result'Class;
      Options : AUnit.Options.AUnit_Options;
      Outcome : out AUnit.Status)
   is
      All_Cases  : aliased Planner := (AUnit.Test_Filters.Test_Filter with Options.Filter);
      Selected   : aliased Starter := (AUnit.Test_Filters.Test_Filter with Options.Filter);
      No_Results : Result;
      Reported   : Reporting_Result (Results'Unchecked_Access);
      Each       : AUnit.Options.AUnit_Options := Options;
   begin
      Is_Running := True;
      --  This runs nothing, but calls Register_Tests of all tests.
      Each.Filter := All_Cases'Unchecked_Access;
      AUnit.Test_Suites.Run (Suite, Each, No_Results, Outcome);
      Send_Plan;
      Each.Filter := Selected'Unchecked_Access;
      AUnit.Test_Suites.Run (Suite, Each, Reported, Outcome);
      Finish_Case;
      Is_Running := False;
      if not Is_Forked then
         Send ("finished", "");
      end if;
   end Run;

end RTF_AUnit_Cases;
