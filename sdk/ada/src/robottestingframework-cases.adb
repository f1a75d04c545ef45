--  SPDX-License-Identifier: Apache-2.0

with Ada.Strings.Fixed;
with Interfaces.C;
with RobotTestingFramework.ABI;
with RobotTestingFramework.Exceptions;
with RobotTestingFramework.Host;
with System;

package body RobotTestingFramework.Cases is

   use type Interfaces.C.int;
   use type Interfaces.C.size_t;

   function Named (Name, Value : String) return Named_Value is ((+Name, +Value));

   function Named (Name : String; Value : Integer) return Named_Value is
     (Named (Name, Ada.Strings.Fixed.Trim (Value'Image, Ada.Strings.Left)));

   --  Starts a case, and returns whether it runs.
   function Starts
     (Table      : not null ABI.Host_Access;
      Name       : String;
      Parameters : Named_Values;
      File       : String;
      Line       : Natural) return Boolean
   is
      All_Texts : Unbounded_String;
   begin
      for Parameter of Parameters loop
         Append (All_Texts, Parameter.Name & Parameter.Value);
      end loop;
      declare
         Name_Text   : aliased constant String := Name;
         Source_Text : aliased constant String := File & ASCII.NUL;
         Content     : aliased constant String := To_String (All_Texts);
         Next        : Positive                := 1;
         Values      : array (Parameters'Range) of aliased ABI.Parameter;
      begin
         for Index in Parameters'Range loop
            Host.Lend (Content, Next, Length (Parameters (Index).Name), Values (Index).Name);
            Host.Lend (Content, Next, Length (Parameters (Index).Value), Values (Index).Value);
         end loop;
         return Table.Case_Begin
           (Table.Context,
            (Size            => ABI.Test_Case'Size / System.Storage_Unit,
             Name            => Host.To_C (Name_Text),
             Parameters      => Values'Address,
             Parameter_Count => Values'Length,
             File            => Source_Text'Address,
             Line            => Interfaces.Unsigned_32 (Line))) /= 0;
      end;
   end Starts;

   procedure Run_Case
     (Name       : String;
      Code       : not null access procedure;
      Parameters : Named_Values := No_Values;
      File       : String       := Source.File;
      Line       : Natural      := Source.Line)
   is
      Table : constant not null ABI.Host_Access := Host.Table_Since_1_3 ("cases", File, Line);
   begin
      if not Starts (Table, Name, Parameters, File, Line) then
         return;
      end if;
      begin
         Code.all;
         Table.Case_End (Table.Context, ABI.Done);
      exception
         when Assertion_Ended =>
            Table.Case_End (Table.Context, ABI.Stopped);
         when Critical_Assertion_Ended | Stop_Requested =>
            Table.Case_End (Table.Context, ABI.Stopped);
            raise;
         when Raised : others =>
            Exceptions.Report (Raised);
            Table.Case_End (Table.Context, ABI.Stopped);
      end;
   end Run_Case;

   procedure Plan_Cases
     (Names : Case_Names; File : String := Source.File; Line : Natural := Source.Line)
   is
      Table     : constant not null ABI.Host_Access := Host.Table_Since_1_3 ("cases", File, Line);
      All_Texts : Unbounded_String;
   begin
      for Name of Names loop
         Append (All_Texts, Name);
      end loop;
      declare
         Content : aliased constant String := To_String (All_Texts);
         Next    : Positive                := 1;
         Texts   : array (Names'Range) of aliased ABI.Text;
      begin
         for Index in Names'Range loop
            Host.Lend (Content, Next, Length (Names (Index)), Texts (Index));
         end loop;
         Table.Plan_Cases (Table.Context, Texts'Address, Texts'Length);
      end;
   end Plan_Cases;

end RobotTestingFramework.Cases;
