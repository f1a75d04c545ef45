--  SPDX-License-Identifier: Apache-2.0

with Ada.Characters.Handling;
with Ada.Strings.Fixed;
with Ada.Strings.Maps;
with Interfaces.C;

package body RobotTestingFramework.Host is

   use Interfaces.C;
   use type ABI.Host_Access;

   Current : ABI.Host_Access with Atomic;

   procedure Connect (To : ABI.Host_Access) is
   begin
      Current := To;
   end Connect;

   function Table return not null ABI.Host_Access is
      Found : constant ABI.Host_Access := Current;
   begin
      if Found = null then
         raise Program_Error
           with "this works only in a plug-in that `rtf run` has started";
      end if;
      return Found;
   end Table;

   function Table_Since_1_3
     (Feature : String; File : String; Line : Natural) return not null ABI.Host_Access
   is
      Found : constant not null ABI.Host_Access := Table;
      Minor : constant String                   := Found.Minor'Image;
      Text  : constant String :=
        "this rtf is too old for " & Feature & ": its plug-in interface is 1."
        & Minor (Minor'First + 1 .. Minor'Last);
   begin
      if Found.Size < ABI.Host_Table'Size / System.Storage_Unit then
         Send (ABI.Error, Text, File, Line);
         raise Assertion_Ended with Text;
      end if;
      return Found;
   end Table_Since_1_3;

   procedure Send
     (Kind       : ABI.Message_Kind;
      Content      : String;
      File       : String;
      Line       : Natural;
      Critical   : Boolean     := False;
      Comparison : ABI.Address := System.Null_Address)
   is
      Host   : constant not null ABI.Host_Access := Table;
      Text   : aliased constant String           := Content;
      Source : aliased constant String           := File & ASCII.NUL;
   begin
      Host.Message
        (Host.Context,
         (Size       => ABI.Message'Size / System.Storage_Unit,
          Kind       => ABI.Message_Kind'Pos (Kind),
          Critical   => Boolean'Pos (Critical),
          Content      => To_C (Text),
          File       => (if File = "" then System.Null_Address else Source'Address),
          Line       => Interfaces.Unsigned_32 (Line),
          Comparison => Comparison));
   end Send;

   function To_C (Content : aliased String) return ABI.Text is
     ((Data => Content'Address, Length => Content'Length));

   function To_Ada (Content : ABI.Text) return String is
      Bytes : String (1 .. Natural (Content.Length)) with Import, Address => Content.Data;
   begin
      return (if Content.Length = 0 then "" else Bytes);
   end To_Ada;

   procedure Lend
     (Content : aliased String; Next : in out Positive; Length : Natural; Text : out ABI.Text) is
   begin
      Text :=
        (Data   => (if Length = 0 then System.Null_Address else Content (Next)'Address),
         Length => Interfaces.C.size_t (Length));
      Next := Next + Length;
   end Lend;

   function Print
     (Buffer : System.Address; Size : size_t; Format : char_array; Value : double) return int
     with Import, Convention => C_Variadic_3, External_Name => "snprintf";

   function Printed (Format : String; Number : Long_Float) return String is
      Buffer : String (1 .. 64);
      Length : constant int :=
        Print (Buffer'Address, Buffer'Length, To_C (Format), double (Number));
   begin
      return Ada.Characters.Handling.To_Lower (Buffer (1 .. Natural (Length)));
   end Printed;

   function Image (Number : Long_Float) return String is
     (if Number /= Number then "nan" else Printed ("%.6g", Number));

   function JSON_Image (Number : Long_Float) return String is
      --  A plug-in may have set a locale with another decimal point.
      Digits_Only : constant String :=
        Ada.Strings.Fixed.Translate
          (Printed ("%.17g", Number), Ada.Strings.Maps.To_Mapping (",", "."));
   begin
      return Digits_Only
        & (if (for some C of Digits_Only => C in '.' | 'e') then "" else ".0");
   end JSON_Image;

end RobotTestingFramework.Host;
