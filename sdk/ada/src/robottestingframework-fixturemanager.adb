--  SPDX-License-Identifier: Apache-2.0

with Ada.Strings.Fixed;
with Interfaces;
with RobotTestingFramework.ABI;
with RobotTestingFramework.Asserter;
with RobotTestingFramework.Entry_Point;
pragma Unreferenced (RobotTestingFramework.Entry_Point);
with RobotTestingFramework.Host;

package body RobotTestingFramework.FixtureManager is

   Instance : FixtureManager_Access;

   function Check (Self : in out FixtureManager) return Boolean is
      pragma Unreferenced (Self);
   begin
      return True;
   end Check;

   function TestStarted (Self : in out FixtureManager; Subject : Test) return Boolean is
      pragma Unreferenced (Self, Subject);
   begin
      return True;
   end TestStarted;

   function TestFinished
     (Self : in out FixtureManager; Subject : Test; Verdict, Reason : String) return Boolean
   is
      pragma Unreferenced (Self, Subject, Verdict, Reason);
   begin
      return True;
   end TestFinished;

   procedure Send
     (Name  : String;
      Kind  : Interfaces.Integer_32;
      Value : String;
      File  : String;
      Line  : Natural)
   is
      Table      : constant not null ABI.Host_Access :=
        Host.Table_Since_1_3 ("values of fixtures", File, Line);
      Name_Text  : aliased constant String := Name;
      Value_Text : aliased constant String := Value;
   begin
      Table.Provide (Table.Context, Host.To_C (Name_Text), Kind, Host.To_C (Value_Text));
   end Send;

   procedure Provide
     (Name, Value : String; File : String := Source.File; Line : Natural := Source.Line) is
   begin
      Send (Name, ABI.Value_Text, Value, File, Line);
   end Provide;

   procedure Provide
     (Name  : String;
      Value : Integer;
      File  : String  := Source.File;
      Line  : Natural := Source.Line) is
   begin
      Provide_JSON
        (Name, Ada.Strings.Fixed.Trim (Value'Image, Ada.Strings.Left), File, Line);
   end Provide;

   procedure Provide
     (Name  : String;
      Value : Long_Float;
      File  : String  := Source.File;
      Line  : Natural := Source.Line) is
   begin
      if not Value'Valid then
         Asserter.Error ("the value of `" & Name & "` is not a finite number", File, Line);
      end if;
      Provide_JSON (Name, Host.JSON_Image (Value), File, Line);
   end Provide;

   procedure Provide
     (Name  : String;
      Value : Boolean;
      File  : String  := Source.File;
      Line  : Natural := Source.Line) is
   begin
      Provide_JSON (Name, (if Value then "true" else "false"), File, Line);
   end Provide;

   procedure Provide_JSON
     (Name, Value : String; File : String := Source.File; Line : Natural := Source.Line) is
   begin
      Send (Name, ABI.Value_JSON, Value, File, Line);
   end Provide_JSON;

   procedure Collapsed (Reason : String) is
      Table : constant not null ABI.Host_Access := Host.Table;
      Text  : aliased constant String           := Reason;
   begin
      Table.Collapsed (Table.Context, Host.To_C (Text));
   end Collapsed;

   package body Register is
      procedure Make is
      begin
         SetFixture (new Fixture);
      end Make;
   end Register;

   procedure SetFixture (Fixture : FixtureManager_Access) is
   begin
      Instance := Fixture;
   end SetFixture;

   function Current return FixtureManager_Access is (Instance);

end RobotTestingFramework.FixtureManager;
