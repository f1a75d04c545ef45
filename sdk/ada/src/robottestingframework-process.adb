--  SPDX-License-Identifier: Apache-2.0

with Interfaces.C.Strings;

package body RobotTestingFramework.Process is

   use Interfaces.C;

   Stored_Count     : Natural        := 0;
   Stored_Arguments : System.Address := System.Null_Address;

   procedure Set_Arguments (Count : int; Arguments : System.Address) is
   begin
      Stored_Count     := (if Count > 1 then Natural (Count) - 1 else 0);
      Stored_Arguments := Arguments;
   end Set_Arguments;

   function Argument_Count return Natural is (Stored_Count);

   function Argument (Number : Positive) return String is
      Words : array (0 .. Stored_Count) of Strings.chars_ptr
        with Import, Address => Stored_Arguments;
   begin
      if Number > Stored_Count then
         raise Constraint_Error
           with "there is no argument" & Number'Image & ", only" & Stored_Count'Image;
      end if;
      return Strings.Value (Words (Number));
   end Argument;

   type Timespec is record
      Seconds     : long;
      Nanoseconds : long;
   end record with Convention => C;

   Clock_Monotonic : constant int := 1;

   function Clock_Gettime (Clock : int; Time : out Timespec) return int
     with Import, Convention => C, External_Name => "clock_gettime";

   function Monotonic return Duration is
      Time    : Timespec;
      Problem : constant int := Clock_Gettime (Clock_Monotonic, Time);
      pragma Unreferenced (Problem);
   begin
      return Duration (Time.Seconds) + Duration (Time.Nanoseconds) / 1_000_000_000;
   end Monotonic;

end RobotTestingFramework.Process;
