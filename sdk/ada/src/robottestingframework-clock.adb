--  SPDX-License-Identifier: Apache-2.0

with Interfaces.C;
with Interfaces.C.Strings;
with RobotTestingFramework.Process;
with System;

package body RobotTestingFramework.Clock is

   use Interfaces.C;
   use type Interfaces.C.Strings.chars_ptr;
   use type System.Address;

   --  Ada.Text_IO would add its files to each plug-in.
   function C_Getenv (Name : char_array) return Strings.chars_ptr
     with Import, Convention => C, External_Name => "getenv";
   function C_Open (Path : Strings.chars_ptr; Mode : char_array) return System.Address
     with Import, Convention => C, External_Name => "fopen";
   function C_Read
     (Into : out char_array; Size, Count : size_t; File : System.Address) return size_t
     with Import, Convention => C, External_Name => "fread";
   function C_Close (File : System.Address) return int
     with Import, Convention => C, External_Name => "fclose";

   Longest : constant := 64;

   --  The file with the simulated time; null for the wall clock.
   function Path return Strings.chars_ptr is
      Value : constant Strings.chars_ptr := C_Getenv (To_C ("RTF_CLOCK"));
   begin
      if Value = Strings.Null_Ptr or else Strings.Strlen (Value) = 0 then
         return Strings.Null_Ptr;
      end if;
      return Value;
   end Path;

   function Is_Simulated return Boolean is (Path /= Strings.Null_Ptr);

   --  The text of the file; empty if it cannot be read.
   function Content (Name : Strings.chars_ptr) return String is
      File   : constant System.Address := C_Open (Name, To_C ("rb"));
      Buffer : char_array (1 .. Longest);
      Count  : size_t;
      Status : int;
      pragma Unreferenced (Status);
   begin
      if File = System.Null_Address then
         return "";
      end if;
      Count  := C_Read (Buffer, 1, Longest, File);
      Status := C_Close (File);
      return To_Ada (Buffer (1 .. Count), Trim_Nul => False);
   end Content;

   --  The clock's time; unknown while the file is being written.
   procedure Read_Clock (Is_Known : out Boolean; Time : out Duration) is
   begin
      Is_Known := True;
      if not Is_Simulated then
         Time := Process.Monotonic;
         return;
      end if;
      Time := 0.0;
      declare
         Text : constant String := Content (Path);
      begin
         Is_Known := Text'Length > 1 and then Text (Text'Last) = ASCII.LF;
         if Is_Known then
            Time := Duration'Value (Text (Text'First .. Text'Last - 1));
         end if;
      end;
   exception
      when Constraint_Error =>
         Is_Known := False;
   end Read_Clock;

   Latest : Duration := 0.0;

   function Now return Duration is
      Is_Known : Boolean;
      Time     : Duration;
   begin
      Read_Clock (Is_Known, Time);
      if Is_Known then
         Latest := Time;
      end if;
      return Latest;
   end Now;

   function Started return Stopwatch is
      Watch : Stopwatch;
   begin
      Read_Clock (Watch.Is_Known, Watch.Before);
      return Watch;
   end Started;

   procedure Read (Watch : in out Stopwatch; Passed : out Duration) is
      Is_Known : Boolean;
      Time     : Duration;
   begin
      Read_Clock (Is_Known, Time);
      if Is_Known then
         if Watch.Is_Known then
            Watch.Passed := Watch.Passed + Duration'Max (0.0, Time - Watch.Before);
         end if;
         Watch.Before   := Time;
         Watch.Is_Known := True;
      end if;
      Passed := Watch.Passed;
   end Read;

end RobotTestingFramework.Clock;
