--  SPDX-License-Identifier: Apache-2.0

with Interfaces;
with RobotTestingFramework.ABI;
with RobotTestingFramework.Host;

package body RobotTestingFramework.Faults is

   use type Interfaces.Integer_32;
   use type Interfaces.Unsigned_32;

   procedure Request
     (Action : Interfaces.Integer_32; Name : String; File : String; Line : Natural)
   is
      Table       : constant not null ABI.Host_Access := Host.Table;
      Name_Text   : aliased constant String := Name;
      Source_Text : aliased constant String := File & ASCII.NUL;
   begin
      if Table.Minor < 4 then
         raise Program_Error with "this rtf is too old for faults";
      end if;
      if Table.Fault
        (Table.Context, Action, Host.To_C (Name_Text), Source_Text'Address,
         Interfaces.Unsigned_32 (Line)) /= ABI.Done
      then
         --  The host has reported the error.
         raise Assertion_Ended with "the fault """ & Name & """";
      end if;
   end Request;

   procedure Inject
     (Name : String; File : String := Source.File; Line : Natural := Source.Line) is
   begin
      Request (ABI.Fault_Inject, Name, File, Line);
   end Inject;

   procedure Remove
     (Name : String; File : String := Source.File; Line : Natural := Source.Line) is
   begin
      Request (ABI.Fault_Remove, Name, File, Line);
   end Remove;

end RobotTestingFramework.Faults;
